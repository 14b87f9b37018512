within GiveWay.Components;
model SeriesBumper "Two springs in series on one guide"
  import Modelica.Units.SI;
  extends Interfaces.PartialLawBumper;
  parameter SI.TranslationalSpringConstant k=robot.bumper_spring_rate "Rate of the first spring";
  parameter SI.Force f_pre=robot.bumper_preload "Preload of the first spring, which the second carries, too";
  parameter SI.Length travel_1=0.03 "Travel of the first spring until it is solid";
  parameter SI.TranslationalSpringConstant k_2=4000 "Rate of the second spring";
  parameter SI.Force f_pre_2=0 "Force below which the second spring does not move";
  SI.Force f_both "Force while both springs give way";
  SI.Force f_second "Force while the first is solid";
  final parameter SI.TranslationalSpringConstant k_both=k*k_2/(k + k_2) "Rate of both";
  final parameter SI.Length c_a=max(f_pre_2 - f_pre, 0)/k "From here both give way";
  final parameter SI.Length c_b=c_a + (travel_1 - c_a)*(1 + k/k_2) "From here the first is solid";
equation
  f_both = f_pre + k*c_a + k_both*(c - c_a);
  f_second = f_pre + k*travel_1 + k_2*(c - c_b);
  f_rest = noEvent(if c < c_a then f_pre + k*c else if c < c_b then f_both else f_second);
  f_rate = 0;
  e_law = f_pre*c + noEvent(if c < c_a then k/2*c^2
    else if c < c_b then k/2*c_a^2 + (k*c_a + k_both/2*(c - c_a))*(c - c_a)
    else k/2*c_a^2 + (k*c_a + k_both/2*(c_b - c_a))*(c_b - c_a) + (k*travel_1 + k_2/2*(c - c_b))*(c - c_b));
  assert(f_pre_2 <= f_pre + k*travel_1, "the second spring gives way only after the first is solid");
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Rectangle(extent={{-90,60},{-70,-60}}, lineColor={64,64,64}, fillColor={128,128,128},
        fillPattern=FillPattern.Solid),
      Line(points={{-70,0},{-50,0},{-38,30},{-14,-30},{10,30},{34,-30},{46,0},{70,0}}, color={64,64,64}, thickness=0.5),
      Rectangle(extent={{70,60},{90,-60}}, lineColor={140,60,0}, fillColor={240,190,140},
        fillPattern=FillPattern.Solid),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>Both carry one force. While it is below the second's preload only the first gives way (rate k), then both (rate
k k<sub>2</sub>/(k + k<sub>2</sub>)), and when the first is solid only the second (rate k<sub>2</sub>). The force has
two corners and no jump.</p>
</html>"));
end SeriesBumper;
