within GiveWay.Functions;
function tableForce "Force of a table over travel and speed, linear between its points"
  import Modelica.Units.SI;
  extends Modelica.Icons.Function;
  input SI.Position travels[:] "Travels of the rows, rising";
  input SI.Velocity speeds[:] "Speeds of the columns, rising";
  input SI.Force forces[:, :] "Forces";
  input SI.Position c "Travel";
  input SI.Velocity u "Speed";
  output SI.Force f "Force at this travel and speed";
protected
  Integer i "Row before the travel";
  Integer j "Column before the speed";
  Real s(unit="1") "Share of the next row";
  Real t(unit="1") "Share of the next column";
algorithm
  i := 1;
  for k in 2:size(travels, 1) - 1 loop
    if c > travels[k] then
      i := k;
    end if;
  end for;
  s := max(0, min(1, (c - travels[i])/(travels[i + 1] - travels[i])));
  if size(speeds, 1) == 1 then
    f := forces[i, 1] + s*(forces[i + 1, 1] - forces[i, 1]);
  else
    j := 1;
    for k in 2:size(speeds, 1) - 1 loop
      if u > speeds[k] then
        j := k;
      end if;
    end for;
    t := (u - speeds[j])/(speeds[j + 1] - speeds[j]);
    f := (1 - t)*(forces[i, j] + s*(forces[i + 1, j] - forces[i, j]))
      + t*(forces[i, j + 1] + s*(forces[i + 1, j + 1] - forces[i, j + 1]));
  end if;
  f := max(0, f);
  annotation (
    Documentation(info="<html>
<p>Constant beyond the first and last travel; beyond the first and last speed the slope goes on. The force is never
negative.</p>
</html>"));
end tableForce;
