within GiveWay.Components;
block JointServo "Position servo of one drive: sampled PD on encoder counts"
  import Modelica.Units.SI;
  parameter SI.RotationalSpringConstant k_p "Gain on the angle";
  parameter SI.RotationalDampingConstant k_d "Gain on the speed";
  parameter SI.Torque limit "Largest torque";
  parameter SI.Frequency cutoff "Cutoff frequency of the filter of the measured speed";
  parameter Integer counts "Encoder counts per turn";
  parameter SI.Angle phi_start=0 "Wanted angle that is on the bus at the start";
  parameter SI.AngularVelocity w_start=0 "Wanted speed that is on the bus at the start";
  parameter SI.Time period=0.0005 "Sample period; a new reference arrives every other sample";
  constant SI.Angle turn=6.283185307179586 "A turn";
  final parameter SI.Angle count_angle=turn/counts "Angle of one count";
  final parameter Real gain(unit="1")=1 - exp(-turn*cutoff*period) "Filter coefficient per sample";
  Interfaces.AngleInput phi_m "Angle of the motor"
    annotation (Placement(transformation(extent={{-110,30},{-90,50}})));
  Interfaces.AngleInput phi_ref "Wanted angle, from the bus"
    annotation (Placement(transformation(extent={{-110,-10},{-90,10}})));
  Interfaces.AngularVelocityInput w_ref "Wanted speed, from the bus"
    annotation (Placement(transformation(extent={{-110,-50},{-90,-30}})));
  Interfaces.TorqueOutput tau_m "Torque of the motor"
    annotation (Placement(transformation(extent={{90,-10},{110,10}})));
  discrete Integer tick(start=-1, fixed=true) "Samples taken";
  discrete Real count(start=0, fixed=true, unit="1") "Encoder count";
  discrete SI.AngularVelocity w(start=0, fixed=true) "Filtered speed";
  discrete SI.Angle wanted(start=0, fixed=true) "Wanted angle, extrapolated between references";
  discrete SI.AngularVelocity w_wanted(start=0, fixed=true) "Wanted speed";
  discrete SI.Torque tau(start=0, fixed=true) "Torque held until the next sample";
equation
  when sample(0, period) then
    tick = pre(tick) + 1;
    count = floor(phi_m/turn*counts);
    w = if tick == 0 then 0 else pre(w) + gain*((count - pre(count))*count_angle/period - pre(w));
    w_wanted = if mod(tick, 2) == 1 then pre(w_wanted) else if tick == 0 then w_start else pre(w_ref);
    wanted = if mod(tick, 2) == 1 then pre(wanted) + w_wanted*period else if tick == 0 then phi_start else pre(phi_ref);
    tau = max(-limit, min(limit, k_p*(wanted - count*count_angle) + k_d*(w_wanted - w)));
  end when;
  tau_m = tau;
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Rectangle(extent={{-90,90},{90,-90}}, lineColor={0,0,127}, fillColor={255,255,255},
        fillPattern=FillPattern.Solid),
      Line(points={{-70,-40},{-40,-40},{-40,0},{-10,0},{-10,40},{20,40},{20,10},{60,10}}, color={0,0,127}),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>&tau;<sub>m</sub> = k<sub>p</sub>(&phi;<sub>ref</sub> &minus; &phi;) + k<sub>d</sub>(&omega;<sub>ref</sub> &minus;
&omega;), limited, 2000 times a second. &phi; is the encoder angle, &omega; its difference quotient after a first-order
filter. A new reference arrives every other sample; in between, the angle is extrapolated with the wanted speed.</p>
<p>The bus has a latency of one cycle of 1 ms: a sample receives what the controller sent one cycle before
(<code>pre</code>).</p>
</html>"));
end JointServo;
