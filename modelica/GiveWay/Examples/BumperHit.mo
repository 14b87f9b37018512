within GiveWay.Examples;
model BumperHit "test"
  extends Modelica.Icons.Example;
  parameter Parameters.Trikey robot "The robot's numbers";
  Components.Testbed testbed(robot=robot) "bed";
equation
  testbed.tau_m = zeros(3);
  annotation (
    experiment(StopTime=0.8, Tolerance=1e-9, Interval=0.001),
    Documentation(info="<html>
x
</html>"));
end BumperHit;
