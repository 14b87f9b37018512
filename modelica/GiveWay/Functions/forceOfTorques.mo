within GiveWay.Functions;
function forceOfTorques "Force of wheel torques in base axes"
  import Modelica.Units.SI;
  extends Modelica.Icons.Function;
  input SI.Torque tau[3] "Wheel torques";
  input SI.Radius r_w "Radius of the wheels";
  output SI.Force F[2] "Force, base axes";
protected
  constant SI.Angle third=2.0943951023931953 "A third of a turn";
algorithm
  F := {-(sin(third)*tau[2] + sin(2*third)*tau[3])/r_w, (tau[1] + cos(third)*tau[2] + cos(2*third)*tau[3])/r_w};
  annotation (
    Documentation(info="<html>
<p>The first two rows of J<sub>w</sub><sup>T</sup> &tau;, the transpose of (15). The third is the moment,
R/r<sub>w</sub> times the sum (42).</p>
</html>"));
end forceOfTorques;
