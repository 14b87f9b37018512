within GiveWay.Components;
model GasBumper "Gas spring or pneumatic cushion"
  import Modelica.Units.SI;
  extends Interfaces.PartialLawBumper;
  parameter SI.Force f_0=50 "Force at full extension";
  parameter SI.Length l_gas=0.2 "Gas volume at full extension over the piston's area";
  parameter Real n(unit="1")=1.2 "Polytropic exponent: 1 isothermal (slow), 1.4 adiabatic (fast)";
  parameter SI.Force f_ambient=0 "Pressure of the air outside times the piston's area; 0 for high-pressure gas springs";
  SI.Position c_gas "Compression of the gas, up to 98 % of its length";
  Real z(unit="1") "Logarithm of the gas's pressure ratio, if isothermal";
  Real w(unit="1") "Work on the gas over that of its first pressure along its whole length";
equation
  c_gas = noEvent(min(c, 0.98*l_gas));
  z = -log(1 - c_gas/l_gas);
  w = if n - 1 < 1e-6 then z*(1 + (n - 1)*z/2) else (exp((n - 1)*z) - 1)/(n - 1);
  f_rest = (f_0 + f_ambient)*exp(n*z) - f_ambient;
  f_rate = 0;
  e_law = (f_0 + f_ambient)*l_gas*w - f_ambient*c_gas + f_rest*(c - c_gas);
  assert(travel <= 0.95*l_gas, "the travel is more than 95 % of the gas's length");
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Rectangle(extent={{-90,60},{-70,-60}}, lineColor={64,64,64}, fillColor={128,128,128},
        fillPattern=FillPattern.Solid),
      Line(points={{-70,0},{-50,0},{-38,30},{-14,-30},{10,30},{34,-30},{46,0},{70,0}}, color={64,64,64}, thickness=0.5),
      Rectangle(extent={{70,60},{90,-60}}, lineColor={140,60,0}, fillColor={240,190,140},
        fillPattern=FillPattern.Solid),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>Polytropic compression, p V<sup>n</sup> = const:</p>
<p>f = (F<sub>0</sub> + F<sub>a</sub>)(1 &minus; c/L)<sup>&minus;n</sup> &minus; F<sub>a</sub>, &nbsp; e<sub>law</sub> =
(F<sub>0</sub> + F<sub>a</sub>) L ((1 &minus; c/L)<sup>1&minus;n</sup> &minus; 1)/(n &minus; 1) &minus; F<sub>a</sub>
c.</p>
<p>From a data sheet with F<sub>1</sub> extended and F<sub>2</sub> after a stroke s: F<sub>0</sub> = F<sub>1</sub>, L =
s/(1 &minus; ((F<sub>1</sub> + F<sub>a</sub>)/(F<sub>2</sub> + F<sub>a</sub>))<sup>1/n</sup>). Its friction and its oil
are <code>f_guide</code> and <code>d</code>.</p>
</html>"));
end GasBumper;
