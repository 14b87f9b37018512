within GiveWay.Examples;
model MotionlessMagnetic "The dummy with a magnetic spring bumper hits the standing robot (5.2)"
  import Modelica.Units.SI;
  extends Modelica.Icons.Example;
  Components.Testbed testbed "Robot and dummy"
    annotation (Placement(transformation(extent={{-80,-20},{-40,20}})));
  Sensors.FirstContact first(touching=testbed.dummy.contact.touching) "First contact"
    annotation (Placement(transformation(extent={{40,-20},{80,20}})));
  SI.Time detection_time "From the first contact to the controller's decision, -1 before";
equation
  detection_time = if testbed.robot.controller.hits > 0 then
    testbed.robot.controller.hit_tick*testbed.robot.controller.period - first.t else first.never;
  annotation (
    experiment(StopTime=0.6, Tolerance=1e-7, Interval=0.001),
    Documentation(info="<html>
<p>5.2 with the magnetic spring bumper: the paper notices the hit after 85 ms.</p><p>The controller notices the impulse,
and the robot starts to escape by 0.5 m with a time constant of 1.25 s; the example ends earlier.</p>
</html>"));
end MotionlessMagnetic;
