within GiveWay.Examples;
model MovingCollision "The robot runs into the resting dummy (5.3)"
  import Modelica.Units.SI;
  extends Modelica.Icons.Example;
  constant SI.Angle side=1.0471975511965976 "Direction in which it moves: the side between wheels 0 and 1 ahead";
  parameter SI.Length way=0.22*(0.5759586531581288/2 + 0.3) "Until they meet: the ramp of the plan, and 0.3 s at speed";
  Components.ControlledRobot robot(redeclare model Plan = Sources.Straight) "Robot";
  Components.Dummy dummy(m=13.62, roped=false, run_up=0, x_target=0.088046 + way*cos(side), y_target=0.1525 + way*sin(side)) "Dummy at rest, without the rope";
  Sensors.FirstContact first(touching=dummy.contact.touching) "First contact";
  SI.Time detection_time "From the first contact to the controller's decision, -1 before";
equation
  connect(robot.frame, dummy.frame);
  detection_time = if robot.controller.hits > 0 then robot.controller.hit_tick*robot.controller.period - first.t else -1;
  annotation (
    experiment(StopTime=1.3, Tolerance=1e-7, Interval=0.001),
    Documentation(info="<html>
<p>5.3: the robot moves at 0.22 m/s with the side between wheels 0 and 1 ahead, and meets 13.62 kg at rest. The paper notices it after 105 ms.</p>
</html>"));
end MovingCollision;
