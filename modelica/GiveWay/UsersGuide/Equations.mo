within GiveWay.UsersGuide;
class Equations "The model on one page"
  extends Modelica.Icons.Information;
  annotation (
    Documentation(info="<html>
<p>Numbers in brackets are those of the paper. World frame: x, y horizontal, &theta; about the vertical. Wheel i has the
radial direction n<sub>i</sub> at &theta; + &phi;<sub>i</sub>, &phi; = 0, 120, 240 deg, and the rolling direction
t<sub>i</sub>, which is n<sub>i</sub> rotated by 90 deg.</p>
<p><b>Sign of the external force.</b> The paper contradicts itself: (31), (36) and (37) use the force of the robot on
its environment, (38) to (44) the force of the environment on the robot. Here it is always the latter.</p>
<p><b>Base</b> (13)-(30): r<sub>w</sub>q&#775;<sub>w,i</sub> = t<sub>i</sub>&middot;x&#775; + R&theta;&#775;,
r<sub>r</sub>q&#775;<sub>r,i</sub> = n<sub>i</sub>&middot;x&#775;; M x&#776; = &Sigma;(F<sub>t,i</sub>t<sub>i</sub>
&minus; F<sub>n,i</sub>n<sub>i</sub>) + F<sub>ext</sub>; I<sub>w</sub>q&#776;<sub>w</sub> = T &minus;
r<sub>w</sub>F<sub>t</sub>; I<sub>r</sub>q&#776;<sub>r</sub> = r<sub>r</sub>(F<sub>n</sub> &minus; f).</p>
<p><b>Drivetrain</b> (Fig. 6): J&theta;&#776;<sub>m</sub> = &tau;<sub>m</sub> &minus; B1(&theta;&#775;<sub>m</sub>)
&minus; T, T = k(&theta;<sub>m</sub> &minus; q<sub>w</sub>) + d(&theta;&#775;<sub>m</sub> &minus;
q&#775;<sub>w</sub>).</p>
<p><b>Rollers</b> (28): f = (B<sub>r</sub>/r<sub>r</sub>) tanh(&alpha;q&#775;<sub>r</sub>) in motion; near rest a
bristle that carries load elastically.</p>
<p><b>Contact</b>: N = max(0, k&delta;(1 + e&delta;&#775;)). <b>Rope</b>: max(0, k e + d e&#775;). <b>Latch</b>:
F<sub>L</sub>/(1 + c/g<sub>0</sub>)<sup>2</sup>, or held and released.</p>
<p><b>Other bumpers</b>, not in the paper: foam, gas spring, damper, two springs in series, lever, table
(<code>Interfaces.PartialLawBumper</code> and what extends it).</p>
<p><b>Estimate</b> (38), (40): F<sub>ext</sub> = J<sub>w</sub><sup>T</sup>(T|<sub>0</sub> &minus; T<sub>s</sub>).
<b>Reaction</b> (2), (47): x(&infin;) = x<sub>0</sub> + p/B with an impulse p = 0.8 N s and B = 1.6 N s/m, which the
paper prints as N and N/m<sup>2</sup>.</p>
<p><b>Not in this package</b>: tipping, bumpers mounted on the robot, a wall behind the dummy, contacts with wheels or
long edges, and the parts of the controller that <code>Components.SampledController</code> lists.</p>
</html>"));
end Equations;
