within GiveWay.Examples;
model RollerWavesPair "Wheels 0 and 1 move in waves, wheel 2 stands still (4.2, Fig. 7d-f)"
  extends Modelica.Icons.Example;
  Components.ServoRobot robot "Robot"
    annotation (Placement(transformation(extent={{40,-20},{80,20}})));
  Sources.WheelWave wave(f=0.5) "Wave of wheels 0 and 1"
    annotation (Placement(transformation(extent={{-80,-20},{-40,20}})));
equation
  connect(wave.phi, robot.phi_wanted[1])
    annotation (Line(points={{-40,5},{40,4}}, color={0,0,127}));
  connect(wave.w, robot.w_wanted[1])
    annotation (Line(points={{-40,-5},{40,-4}}, color={0,0,127}));
  connect(wave.phi, robot.phi_wanted[2])
    annotation (Line(points={{-40,5},{40,4}}, color={0,0,127}));
  connect(wave.w, robot.w_wanted[2])
    annotation (Line(points={{-40,-5},{40,-4}}, color={0,0,127}));
  robot.phi_wanted[3] = 0;
  robot.w_wanted[3] = 0;
  annotation (
    experiment(StopTime=1.2, Tolerance=1e-7, Interval=0.001),
    Documentation(info="<html>
<p>Fig. 7d: the base turns about wheel 2, whose roller therefore does not slide. Friction of the other two appears as
square waves in the ratio 1 : 1 : &minus;2, the largest on the standing wheel. Inertia adds to them, as the wave is
quicker than the paper's. The paper uses this experiment to validate its fit to the first one.</p>
</html>"));
end RollerWavesPair;
