within GiveWay.UsersGuide;
class Concept "How the package is built"
  extends Modelica.Icons.Information;
  annotation (
    Documentation(info="<html>
<p>Trikey is a mobile base on three omnidirectional wheels. Its only sensors for collisions are torque sensors in the
three drivetrains: the torques of the motion alone are compared with the sensed torques, and the difference is the
external force. When its impulse exceeds a threshold, the base moves away along it.</p>
<p>The package has the plant as equations and the controller as one sampled block, so every experiment of the paper runs
without another tool.</p>
<ul>
<li><b>Three physical connectors</b> (<code>Interfaces</code>): a shaft at the wheel axle, a point on a rail, a frame in
the plane. Everything behind a gear is reflected to the wheel axle.</li>
<li><b>Modes are discrete variables</b>, changed in <code>when</code> clauses: a gear sticks or slides, a latch holds or
not, a rope is taut or slack. Stiction is true stiction: a stuck gear does not creep.</li>
<li><b>Parts are swapped by redeclaring a model</b> without modifiers; a part finds its parameters in the record
<code>Parameters.Trikey</code>, which is passed to every part. Examples: <code>Components.Slider(redeclare model Bumper
= Components.SpringBumper)</code>, <code>Components.ControlledRobot(redeclare model Plan = Sources.Circle)</code>,
<code>Components.Omniwheel(redeclare model Roller = Components.TanhRoller)</code>.</li>
<li><b>One source of parameters</b>: the record is generated from the robot file of the project, with the provenance of
each number.</li>
<li><b>A second statement</b>: the same plant exists as FMUs in the project this package belongs to, written separately;
tests compare the trajectories of both.</li>
</ul>
<p>Only <code>Modelica.Units</code> and <code>Modelica.Icons</code> are used. Frictions, latches and contacts are
defined in this package.</p>
</html>"));
end Concept;
