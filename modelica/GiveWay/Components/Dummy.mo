within GiveWay.Components;
model Dummy "Collision dummy on its rail, with rope, bumper and cover"
  import Modelica.Units.SI;
  parameter Parameters.Trikey robot "Parameters of dummy, bumper and outline";
  parameter SI.Mass m=robot.slider_mass "Whole sliding mass";
  parameter SI.Velocity v_start=0 "Speed at the start";
  parameter Boolean roped=true "A hanging weight pulls the dummy";
  parameter SI.Angle psi=-2.094395102393195 "Direction of the rail, world frame";
  parameter SI.Position x_target=0.088046 "Position of the tip after the run-up, world frame";
  parameter SI.Position y_target=0.1525 "Position of the tip after the run-up, world frame";
  parameter SI.Length run_up=robot.slider_run_up "Travel until the tip is there";
  Interfaces.PlanarFrame frame "Centre of the robot"
    annotation (Placement(transformation(extent={{90,-10},{110,10}})));
  replaceable Slider slider(robot=robot, m=m, v_start=v_start) constrainedby Slider(robot=robot, m=m, v_start=v_start)
    "Slider with its bumper"
    annotation (Placement(transformation(extent={{-80,40},{-40,80}})));
  HangingWeight weight(m=robot.rope_hanging_mass, k=robot.rope_stiffness, d=robot.rope_damping,
    drop=robot.rope_drop_height, v_start=v_start) if roped "Hanging weight that pulls the dummy"
    annotation (Placement(transformation(extent={{40,40},{80,80}})));
  DiscContact contact(robot=robot, psi=psi, x_target=x_target, y_target=y_target, run_up=run_up)
    "Contact between nose and robot"
    annotation (Placement(transformation(extent={{-80,-80},{-40,-40}})));
equation
  connect(frame, contact.base)
    annotation (Line(points={{100,0},{-80,-60}}, color={0,70,140}));
  connect(slider.nose, contact.nose)
    annotation (Line(points={{-40,60},{-40,-60}}, color={0,70,140}));
  connect(weight.rope, slider.rope)
    annotation (Line(points={{80,60},{-80,60}}, color={0,70,140}));
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Rectangle(extent={{-70,40},{60,-10}}, lineColor={64,64,64}, fillColor={192,192,192},
        fillPattern=FillPattern.Solid),
      Line(points={{-95,-20},{95,-20}}, color={0,0,0}, thickness=0.5),
      Ellipse(extent={{60,35},{90,-5}}, lineColor={140,60,0}, fillColor={240,190,140}, fillPattern=FillPattern.Solid),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>The dummy of 3.4: slider, weight over a pulley, bumper, and its nose's contact with the outline of the robot. By
default it hits the middle of the side between wheels 0 and 1 at right angles, at the speed of 5.2.</p>
</html>"));
end Dummy;
