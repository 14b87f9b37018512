within GiveWay.Functions;
function closestPoint "Point of a convex polygon closest to a given point"
  import Modelica.Units.SI;
  extends Modelica.Icons.Function;
  input SI.Position q_x "The point";
  input SI.Position q_y "The point";
  input SI.Position x[:] "Corners, counter-clockwise";
  input SI.Position y[size(x, 1)] "Corners, counter-clockwise";
  output SI.Position distance "Signed distance: negative inside";
  output Real n_x(unit="1") "Outward unit normal";
  output Real n_y(unit="1") "Outward unit normal";
protected
  Integer n=size(x, 1) "Number of corners";
  Integer j "Index of the next corner";
  SI.Length length "Length of an edge";
  Real t_x(unit="1") "Unit vector along an edge";
  Real t_y(unit="1") "Unit vector along an edge";
  SI.Position height "Height of the point above the line of an edge";
  SI.Position along "Distance of the nearest point of an edge from the edge's first corner";
  SI.Position o_x "Vector from the nearest point to the given point";
  SI.Position o_y "Vector from the nearest point to the given point";
  SI.Distance offset "Length of that vector";
  SI.Position highest "Largest height above the line of any edge";
  SI.Distance nearest "Smallest distance to any edge";
  Real m_x(unit="1") "Normal of the line with the largest height";
  Real m_y(unit="1") "Normal of the line with the largest height";
algorithm
  highest := -1e300;
  nearest := 1e300;
  n_x := 1;
  n_y := 0;
  m_x := 1;
  m_y := 0;
  for i in 1:n loop
    j := if i == n then 1 else i + 1;
    length := sqrt((x[j] - x[i])^2 + (y[j] - y[i])^2);
    t_x := (x[j] - x[i])/length;
    t_y := (y[j] - y[i])/length;
    height := (q_x - x[i])*t_y - (q_y - y[i])*t_x;
    if height > highest then
      highest := height;
      m_x := t_y;
      m_y := -t_x;
    end if;
    along := max(0, min(length, (q_x - x[i])*t_x + (q_y - y[i])*t_y));
    o_x := q_x - x[i] - along*t_x;
    o_y := q_y - y[i] - along*t_y;
    offset := sqrt(o_x^2 + o_y^2);
    if offset < nearest then
      nearest := offset;
      n_x := o_x/max(offset, 1e-12);
      n_y := o_y/max(offset, 1e-12);
    end if;
  end for;
  if highest > 0 then
    distance := nearest;
  else
    distance := highest;
    n_x := m_x;
    n_y := m_y;
  end if;
  annotation (
    Documentation(info="<html>
<p>Outside it is the nearest point of any edge; inside it is the nearest point of the nearest edge's line. The closest
point itself is q &minus; distance&middot;n.</p>
</html>"));
end closestPoint;
