within GiveWay.Components;
model HangingWeight "Weight on a rope over a pulley, with the floor it lands on"
  import Modelica.Units.SI;
  parameter SI.Mass m "Mass of the weight";
  parameter SI.TranslationalSpringConstant k "Stiffness of the rope";
  parameter SI.TranslationalDampingConstant d "Damping of the rope";
  parameter SI.Length drop "Drop after which the weight lands";
  parameter SI.TranslationalSpringConstant k_floor=2e4 "Stiffness of the floor";
  parameter Real e_floor(unit="s/m")=2 "Damping of the floor (Hunt and Crossley)";
  parameter SI.Velocity v_start=0 "Speed at the start";
  constant SI.Acceleration g=9.81 "Gravitational acceleration";
  Interfaces.LinearFlange rope "End of the rope at the slider"
    annotation (Placement(transformation(extent={{90,-10},{110,10}})));
  SI.Position h(start=0, fixed=true) "Drop of the weight";
  SI.Velocity w(start=v_start, fixed=true) "Its speed, downwards";
  SI.Position extension "Extension of the rope beyond its slack length";
  Boolean taut "The rope is taut";
  SI.Force tension "Force of the rope";
  SI.Force f_floor "Force of the floor on the weight";
equation
  extension = m*g/k + h - rope.s;
  taut = extension > 0;
  tension = if taut then noEvent(max(0, k*extension + d*(w - der(rope.s)))) else 0;
  f_floor = if h > drop then noEvent(max(0, k_floor*(h - drop)*(1 + e_floor*w))) else 0;
  der(h) = w;
  m*der(w) = m*g - tension - f_floor;
  rope.f = -tension;
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Line(points={{-90,60},{40,60},{40,0}}, color={64,64,64}, thickness=0.5),
      Rectangle(extent={{10,0},{70,-70}}, lineColor={64,64,64}, fillColor={160,160,160}, fillPattern=FillPattern.Solid),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>The rope of 3.4 is a spring-damper that only pulls, with the static pretension m g/k at the start: F<sub>r</sub> =
max(0, k e + d e&#775;), e = m g/k + h &minus; s. When the dummy is slowed down the rope tightens, so the weight keeps
pulling until it lands.</p>
</html>"));
end HangingWeight;
