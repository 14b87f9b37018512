within ;
package GiveWay "Collisions of an omnidirectional robot base, and its reflex"
  extends Modelica.Icons.Package;
  annotation (
    version="0.1.0",
    uses(Modelica(version="4.0.0")),
    Documentation(info="<html>
<p>The plant of Kim, Llado and Sentis, <em>Full-body collision detection and reaction with omnidirectional mobile
platforms</em> (2016), as equations: the robot Trikey, whose three drivetrains carry torque sensors, the collision dummy
that hits the robot, bumpers, and the sampled controller that notices the hit and gives way. Start with
<code>UsersGuide</code> and <code>Examples</code>.</p>
</html>"));
end GiveWay;
