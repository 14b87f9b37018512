within GiveWay.Components;
model Load "Load of a drivetrain on the bench, with the friction B2 of its environment"
  import Modelica.Units.SI;
  parameter SI.Inertia J "Inertia about the axle";
  parameter SI.Torque coulomb=0 "Sliding level of the friction";
  parameter Real slope(unit="s/rad")=1 "Softening of the friction, as alpha in (28)";
  parameter SI.RotationalDampingConstant viscous=0 "Viscous friction";
  Interfaces.RotaryFlange axle "Axle"
    annotation (Placement(transformation(extent={{-110,17},{-90,37}})));
  Interfaces.TorqueInput tau_ext "Torque of the environment on the load"
    annotation (Placement(transformation(extent={{-110,-37},{-90,-17}})));
  SI.Angle phi(start=0, fixed=true) "Angle";
  SI.AngularVelocity w(start=0, fixed=true) "Speed";
  SI.Torque friction "Friction B2, against the motion";
equation
  axle.phi = phi;
  der(phi) = w;
  friction = coulomb*tanh(slope*w) + viscous*w;
  J*der(w) = axle.tau - friction + tau_ext;
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Ellipse(extent={{-70,70},{70,-70}}, lineColor={64,64,64}, fillColor={224,224,224}, fillPattern=FillPattern.Solid),
      Ellipse(extent={{-12,12},{12,-12}}, lineColor={64,64,64}, fillColor={64,64,64}, fillPattern=FillPattern.Solid),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>The downstream end of Fig. 6 on a bench: J w&#775; = T &minus; B2(w) + &tau;<sub>ext</sub>, with B2 = B tanh(&alpha;
w) + b w.</p>
</html>"));
end Load;
