within GiveWay.Components;
model Slider "Collision dummy: a slider on a rail with a bumper at its nose"
  import Modelica.Units.SI;
  parameter Parameters.Trikey robot "Parameters of dummy and bumper";
  parameter SI.Mass m=robot.slider_mass "Whole sliding mass, plate included";
  parameter SI.Mass m_p=robot.bumper_plate_mass "Mass of the plate";
  parameter SI.Force coulomb=robot.slider_friction "Coulomb friction of the rail";
  parameter SI.TranslationalDampingConstant viscous=robot.slider_damping "Viscous friction of the rail";
  parameter SI.Velocity v_c=0.005 "Speed over which the Coulomb friction changes sign";
  parameter SI.Velocity v_start=0 "Speed at the start";
  Interfaces.LinearFlange rope "Point where the rope pulls"
    annotation (Placement(transformation(extent={{-110,-10},{-90,10}})));
  Interfaces.LinearFlange nose "Nose, in front of the bumper"
    annotation (Placement(transformation(extent={{90,-10},{110,10}})));
  replaceable model Bumper = MagneticBumper constrainedby Interfaces.PartialBumper "Kind of bumper";
  Bumper bumper(robot=robot, m_reduced=m_p*(m - m_p)/m, f_lock=m_p/m*f_drive + (m - m_p)/m*f_contact)
    "Bumper between carriage and plate"
    annotation (Placement(transformation(extent={{-20,-20},{20,20}})));
  SI.Position s(start=0, fixed=true) "Travel of the carriage";
  SI.Velocity v_mean(start=v_start, fixed=true) "Speed of the common centre of mass";
  SI.Velocity v "Speed of the carriage";
  SI.Force f_drive "Force that drives the carriage along the rail";
  SI.Force f_contact "Contact force against the nose";
equation
  v = v_mean + m_p/m*bumper.u;
  der(s) = v;
  rope.s = s;
  nose.s = s - bumper.c;
  f_contact = -nose.f;
  f_drive = rope.f - coulomb*tanh(v/v_c) - viscous*v;
  m*der(v_mean) = f_drive - f_contact;
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Rectangle(extent={{-70,40},{60,-10}}, lineColor={64,64,64}, fillColor={192,192,192},
        fillPattern=FillPattern.Solid),
      Line(points={{-95,-20},{95,-20}}, color={0,0,0}, thickness=0.5),
      Ellipse(extent={{60,35},{90,-5}}, lineColor={140,60,0}, fillColor={240,190,140}, fillPattern=FillPattern.Solid),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>The slider of 3.4 with the plate of its bumper. Its coordinates are the travel s of the carriage, the compression c,
and the speed V of the common centre of mass:</p>
<p>m V&#775; = F<sub>d</sub> &minus; N, &nbsp; s&#775; = V + (m<sub>p</sub>/m) c&#775;, &nbsp; the nose is at s &minus;
c.</p>
<p>An impact between plate and carriage changes c&#775; alone.</p>
</html>"));
end Slider;
