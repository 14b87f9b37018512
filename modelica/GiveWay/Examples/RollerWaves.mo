within GiveWay.Examples;
model RollerWaves "Wheel 0 moves in waves, the other two stand still (4.2, Fig. 7a-c)"
  extends Modelica.Icons.Example;
  Components.ServoRobot robot "Robot"
    annotation (Placement(transformation(extent={{40,-20},{80,20}})));
  Sources.WheelWave wave(f=0.5) "Wave of wheel 0"
    annotation (Placement(transformation(extent={{-80,-20},{-40,20}})));
equation
  connect(wave.phi, robot.phi_wanted[1])
    annotation (Line(points={{-40,5},{40,4}}, color={0,0,127}));
  connect(wave.w, robot.w_wanted[1])
    annotation (Line(points={{-40,-5},{40,-4}}, color={0,0,127}));
  robot.phi_wanted[2] = 0;
  robot.w_wanted[2] = 0;
  robot.phi_wanted[3] = 0;
  robot.w_wanted[3] = 0;
  annotation (
    experiment(StopTime=1.2, Tolerance=1e-7, Interval=0.001),
    Documentation(info="<html>
<p>Fig. 7a: the base swings in an arc about a point outside it, and roller friction appears as square waves on all three
torque sensors, in the ratio 2 : &minus;1 : &minus;1. One wave of 2 s replaces the paper's slower ones.</p>
</html>"));
end RollerWaves;
