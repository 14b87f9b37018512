within GiveWay.Functions;
function wheelRates "Wheel speeds for a twist in base axes (13), (15)"
  import Modelica.Units.SI;
  extends Modelica.Icons.Function;
  input SI.Velocity v[2] "Velocity, base axes";
  input SI.AngularVelocity omega "Yaw rate";
  input SI.Distance R "Distance from the base's centre to the wheels";
  input SI.Radius r_w "Radius of the wheels";
  output SI.AngularVelocity w[3] "Wheel speeds";
protected
  constant SI.Angle third=2.0943951023931953 "A third of a turn";
algorithm
  for i in 1:3 loop
    w[i] := (-sin((i - 1)*third)*v[1] + cos((i - 1)*third)*v[2] + R*omega)/r_w;
  end for;
  annotation (
    Documentation(info="<html>
<p>q&#775;<sub>w,i</sub> = (&minus;sin &phi;<sub>i</sub> v<sub>x</sub> + cos &phi;<sub>i</sub> v<sub>y</sub> + R
&omega;)/r<sub>w</sub></p>
</html>"));
end wheelRates;
