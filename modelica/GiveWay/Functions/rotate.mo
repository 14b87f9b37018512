within GiveWay.Functions;
function rotate "A vector rotated by an angle"
  import Modelica.Units.SI;
  extends Modelica.Icons.Function;
  input Real v[2] "The vector, of any unit";
  input SI.Angle angle "Angle, positive about z";
  output Real u[2] "The rotated vector, of the same unit";
algorithm
  u := {cos(angle)*v[1] - sin(angle)*v[2], sin(angle)*v[1] + cos(angle)*v[2]};
  annotation (
    Documentation(info="<html>
<p>From base axes to world axes with the heading, and back with the negative heading.</p>
</html>"));
end rotate;
