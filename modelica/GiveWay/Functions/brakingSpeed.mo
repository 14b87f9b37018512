within GiveWay.Functions;
function brakingSpeed "Speed from which a sampled deceleration stops within a distance"
  import Modelica.Units.SI;
  extends Modelica.Icons.Function;
  input SI.Acceleration a "Deceleration";
  input SI.Time period "Sample period";
  input SI.Position distance "Remaining distance";
  output SI.Velocity speed "Speed";
algorithm
  speed := if distance > 0 then sqrt((a*period/2)^2 + 2*a*distance) - a*period/2 else 0;
  annotation (
    Documentation(info="<html>
<p>v<sup>2</sup> = 2 a (s &minus; T v/2): the distance includes the motion of the sample that begins with v.</p>
</html>"));
end brakingSpeed;
