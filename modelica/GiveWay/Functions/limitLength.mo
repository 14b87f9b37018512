within GiveWay.Functions;
function limitLength "A velocity, shortened if it is longer than a limit"
  import Modelica.Units.SI;
  extends Modelica.Icons.Function;
  input SI.Velocity v[2] "The velocity";
  input SI.Velocity limit "Largest length";
  output SI.Velocity u[2] "Limited velocity";
algorithm
  u := v*min(1, limit/max(sqrt(v[1]^2 + v[2]^2), 1e-300));
  annotation (
    Documentation(info="<html>
<p>The direction is kept.</p>
</html>"));
end limitLength;
