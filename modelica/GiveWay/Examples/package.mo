within GiveWay;
package Examples "Every experiment of the paper, and components on a bench"
  extends Modelica.Icons.ExamplesPackage;
  annotation (
    Documentation(info="<html>
<p>All examples are complete and simulate as they are. They end where nothing more happens, often earlier than in the
paper.</p>
<table border=\"1\">
<tr><th>example</th><th>paper</th><th>what to look at</th></tr>
<tr><td>RollerWaves</td><td>4.2, Fig. 7a-c</td><td>robot.tau_s: square waves, 2 : -1 : -1</td></tr>
<tr><td>RollerWavesPair</td><td>4.2, Fig. 7d-f</td><td>the same, 1 : 1 : -2</td></tr>
<tr><td>StaticPush</td><td>5.1</td><td>sensed against true force: rollers at rest carry a part of it</td></tr>
<tr><td>MotionlessNoBumper, MotionlessSpring, MotionlessMagnetic</td><td>5.2, Fig. 10</td><td>detection_time,
testbed.robot.tau_s</td></tr>
<tr><td>MovingCollision</td><td>5.3, Fig. 11</td><td>the same</td></tr>
<tr><td>CirclePushed</td><td>5.4, Fig. 12</td><td>its beginning with two pushes: robot.base.body.x, y</td></tr>
<tr><td>CircleRound</td><td>5.4, Fig. 12</td><td>the full circle with a push, the escape and the return: the same,
robot.controller.mode</td></tr>
<tr><td>DrivetrainStep, BumperDrop, LatchRelease, BumperSweep</td><td>3.2, 3.5</td><td>components on a bench</td></tr>
<tr><td>BumperFoam, BumperGas, BumperDamper, BumperSeries, BumperLever, BumperTable</td><td></td><td>other bumpers:
slider.bumper.f over slider.bumper.c, energy</td></tr>
</table>
</html>"));
end Examples;
