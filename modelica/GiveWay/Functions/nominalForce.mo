within GiveWay.Functions;
function nominalForce "Force that the wheels need for the motion alone (38), in base axes"
  import Modelica.Units.SI;
  extends Modelica.Icons.Function;
  input SI.Velocity v[2] "Velocity, base axes";
  input SI.AngularVelocity omega "Yaw rate";
  input SI.Acceleration a[2] "Acceleration, base axes";
  input SI.Mass m "Mass of the base";
  input SI.Mass m_roll "Mass that wheels and rollers add to it";
  input SI.Torque coulomb "B_r of (28)";
  input Real slope(unit="s/rad") "alpha of (28)";
  input SI.Radius r_r "Radius of the rollers";
  output SI.Force F[2] "Force, base axes";
protected
  constant SI.Angle third=2.0943951023931953 "A third of a turn";
  SI.Force f "Friction of one wheel's rollers";
algorithm
  F := {(m + m_roll)*a[1] + m_roll*omega*v[2], (m + m_roll)*a[2] - m_roll*omega*v[1]};
  for i in 1:3 loop
    f := coulomb/r_r*tanh(slope*(cos((i - 1)*third)*v[1] + sin((i - 1)*third)*v[2])/r_r);
    F := {F[1] + cos((i - 1)*third)*f, F[2] + sin((i - 1)*third)*f};
  end for;
  annotation (
    Documentation(info="<html>
<p>M<sub>t</sub> x&#776; + c + J<sub>r</sub><sup>T</sup> B<sub>r</sub>: (38) before its division by
J<sub>w</sub><sup>T</sup>, with the inertia of wheels and rollers of (27).</p>
</html>"));
end nominalForce;
