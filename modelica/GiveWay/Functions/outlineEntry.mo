within GiveWay.Functions;
function outlineEntry "Where a force enters a convex outline (41)-(46)"
  import Modelica.Units.SI;
  extends Modelica.Icons.Function;
  input Real u[2](each unit="1") "Direction of the force, base axes";
  input SI.Position arm "Lever arm: moment about the centre divided by the force";
  input SI.Position x[:] "Corners of the outline, counter-clockwise";
  input SI.Position y[:] "Corners of the outline, counter-clockwise";
  output SI.Position p[2] "Point of the outline";
protected
  Integer n "Number of corners";
  Integer j "Next corner";
  SI.Position side "Distance of a corner to the right of the line of action";
  SI.Position side_next "The same for the next corner";
  SI.Position nearest "Distance of the nearest corner so far";
  Boolean enters "An edge that the force enters has been found";
algorithm
  n := size(x, 1);
  nearest := 1e9;
  enters := false;
  p := {x[1], y[1]};
  for i in 1:n loop
    j := if i == n then 1 else i + 1;
    side := x[i]*u[2] - y[i]*u[1] - arm;
    side_next := x[j]*u[2] - y[j]*u[1] - arm;
    if side <= 0 and side_next > 0 then
      p := {x[i] + side/(side - side_next)*(x[j] - x[i]), y[i] + side/(side - side_next)*(y[j] - y[i])};
      enters := true;
    elseif not enters and abs(side) < nearest then
      nearest := abs(side);
      p := {x[i], y[i]};
    end if;
  end for;
  annotation (
    Documentation(info="<html>
<p>All points p with p &times; u = d lie on the line of action of the force (43); the contact is where this line enters
the outline, since a cover can only be pushed (44)-(46). If noise shifts the line past the outline, the result is the
nearest corner.</p>
</html>"));
end outlineEntry;
