within GiveWay.Components;
model FoamBumper "Foam: progressive, stiffer with speed, with hysteresis"
  import Modelica.Units.SI;
  extends Interfaces.PartialLawBumper;
  parameter SI.Length h=0.15 "Thickness, uncompressed";
  parameter SI.Force f_25=25 "Force at 25 % of the thickness, slow loading";
  parameter SI.Force f_50=45 "Force at 50 %";
  parameter SI.Force f_75=110 "Force at 75 %";
  parameter Real hysteresis(unit="1")=0.3 "Share of the work of slow loading that slow unloading does not return";
  parameter SI.Velocity u_h=0.02 "Speed over which the hysteresis builds up";
  parameter Real rate_gain(unit="s/m")=0.3 "Greater force per speed, as a share of that of slow loading";
  final parameter SI.Force a[3]={12*f_25 - 6*f_50 + 4/3*f_75, -40*f_25 + 32*f_50 - 8*f_75,
    32*f_25 - 32*f_50 + 32/3*f_75} "Coefficients of the cubic through the three forces";
  final parameter Real x_flat(unit="1")=if a[3] > 0 then max(0, min(travel/h, -a[2]/(3*a[3]))) else travel/h
    "Where the cubic rises least, or the end of the travel";
  Real x(unit="1") "Compression over thickness";
  SI.Force f_loading "Force of slow loading";
  Real share(unit="1") "Force over that of slow loading";
equation
  x = noEvent(max(c, 0))/h;
  f_loading = x*(a[1] + x*(a[2] + x*a[3]));
  share = noEvent(max(0, 1 - hysteresis/2 + hysteresis/2*tanh(u/u_h) + rate_gain*u));
  f_rest = (1 - hysteresis/2)*f_loading;
  f_rate = (share - (1 - hysteresis/2))*f_loading;
  e_law = (1 - hysteresis/2)*h*x^2*(a[1]/2 + x*(a[2]/3 + x*a[3]/4));
  assert(travel <= 0.95*h, "the travel is more than 95 % of the foam's thickness");
  assert(a[1] > 0 and a[1] + x_flat*(2*a[2] + 3*x_flat*a[3]) > 0,
    "the force of the foam does not rise all over the travel");
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Rectangle(extent={{-90,60},{-70,-60}}, lineColor={64,64,64}, fillColor={128,128,128},
        fillPattern=FillPattern.Solid),
      Line(points={{-70,0},{-50,0},{-38,30},{-14,-30},{10,30},{34,-30},{46,0},{70,0}}, color={64,64,64}, thickness=0.5),
      Rectangle(extent={{70,60},{90,-60}}, lineColor={140,60,0}, fillColor={240,190,140},
        fillPattern=FillPattern.Solid),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>A data sheet states forces of slow loading at 25, 50 and 75 % of the thickness; S(x) is the cubic through them and 0,
x = c/h. With speed</p>
<p>f = S(x) max(0, 1 &minus; H/2 + (H/2) tanh(c&#775;/v<sub>h</sub>) + q c&#775;),</p>
<p>so slow loading is S, slow unloading (1 &minus; H) S, and a slow loop loses H times the work of loading. Without
speed: f<sub>rest</sub> = (1 &minus; H/2) S, e<sub>law</sub> = (1 &minus; H/2) h x<sup>2</sup>(a<sub>1</sub>/2 +
x(a<sub>2</sub>/3 + x a<sub>3</sub>/4)).</p>
<p>There is no creep, no relaxation and no set.</p>
</html>"));
end FoamBumper;
