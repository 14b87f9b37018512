within GiveWay.Components;
model BristleRoller "Roller friction with presliding: an elasto-plastic bristle"
  import Modelica.Units.SI;
  extends Interfaces.PartialRollerFriction;
  parameter SI.TranslationalSpringConstant sigma_0=robot.roller_presliding_stiffness "Presliding stiffness";
  parameter SI.TranslationalDampingConstant sigma_1=robot.roller_presliding_damping "Presliding damping";
  parameter SI.Velocity v_stribeck=robot.roller_stribeck_speed "Speed over which stiction gives way to (28)";
  parameter Real rho_ba(unit="1")=robot.roller_elastic_fraction
    "Share of the sliding deflection that is purely elastic";
  final parameter Real w_start(unit="1")=exp(-(v_start/v_stribeck)^2)
    "Share of stiction in the sliding level at the start";
  final parameter SI.Position z_start=sign(v_start)*coulomb/r_r*(w_start
    + (1 - w_start)*tanh(slope*abs(v_start)/r_r))/sigma_0
    "Deflection in steady motion at the start";
  SI.Position z(start=z_start, fixed=true) "Deflection of the bristle";
  SI.Force g "Sliding level at this speed";
  Real share(unit="1") "Share of stiction in the sliding level";
  Real rho(unit="1") "Deflection over that of sliding";
  Real plastic(unit="1") "Position between elastic (0) and fully sliding (1)";
  Real onset(unit="1") "Share of the motion that slides: 0 while elastic, 1 beyond the sliding level";
equation
  share = exp(-(v/v_stribeck)^2);
  g = coulomb/r_r*(share + (1 - share)*tanh(slope*abs(v)/r_r));
  rho = sigma_0*abs(z)/g;
  onset = noEvent(max(0, min(1, (rho - rho_ba)/(1 - rho_ba))));
  plastic = noEvent(if z*v > 0 then onset^2*(3 - 2*onset) else 0);
  der(z) = v*(1 - plastic*rho);
  f = sigma_0*z + sigma_1*der(z);
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Line(points={{-80,-50},{-20,-50},{-10,-30},{10,30},{20,50},{80,50}}, color={140,60,0}, thickness=0.5),
      Line(points={{-90,0},{90,0}}, color={160,160,160}), Line(points={{0,80},{0,-80}}, color={160,160,160}),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>Elasto-plastic bristle (Dupont et al. 2002) whose sliding level goes from F<sub>C</sub> = B<sub>r</sub>/r<sub>r</sub>
at rest to (28) in motion:</p>
<p>w = exp(&minus;(v/v<sub>S</sub>)<sup>2</sup>), &nbsp; g = F<sub>C</sub>(w + (1 &minus; w)
tanh(&alpha;|v|/r<sub>r</sub>)), &nbsp; &rho; = &sigma;<sub>0</sub>|z|/g</p>
<p>z&#775; = v (1 &minus; A(&rho;) &rho;), &nbsp; f = &sigma;<sub>0</sub> z + &sigma;<sub>1</sub> z&#775;</p>
<p>A is 0 for &rho; below &rho;<sub>ba</sub>, so that a static load does not creep, 1 for &rho; above 1, and 0 while the
bristle relaxes. The bristle carries a part of a static push past the torque sensors (5.1).</p>
</html>"));
end BristleRoller;
