within GiveWay.Interfaces;
partial model PartialRollerFriction "Friction of the rollers of one wheel on the floor"
  import Modelica.Units.SI;
  parameter Parameters.Trikey robot "The robot's parameters";
  parameter SI.Torque coulomb=robot.roller_coulomb_torque "Sliding torque B_r of one roller (28)";
  parameter Real slope(unit="s/rad")=robot.roller_tanh_slope "Softening alpha of (28)";
  parameter SI.Radius r_r=robot.roller_radius "Radius of a roller";
  parameter SI.Velocity v_start=0 "Speed of steady motion at the start";
  input SI.Velocity v "Speed of the wheel along its axle";
  SI.Force f "Friction force of the floor, against that motion";
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Line(points={{-80,-50},{-20,-50},{-10,-30},{10,30},{20,50},{80,50}}, color={140,60,0}, thickness=0.5),
      Line(points={{-90,0},{90,0}}, color={160,160,160}), Line(points={{0,80},{0,-80}}, color={160,160,160}),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>Friction between a roller and the floor, as a law f(v) or with an internal state. Common to all are the sliding level
F<sub>C</sub> = B<sub>r</sub>/r<sub>r</sub> and the softening &alpha; of (28):</p>
<p>B<sub>r,i</sub> = B<sub>r</sub> tanh(&alpha; q&#775;<sub>r,i</sub>), with q&#775;<sub>r</sub> = v/r<sub>r</sub>.</p>
</html>"));
end PartialRollerFriction;
