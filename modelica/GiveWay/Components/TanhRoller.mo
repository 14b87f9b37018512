within GiveWay.Components;
model TanhRoller "Roller friction of the estimator: tanh (28)"
  extends Interfaces.PartialRollerFriction;
equation
  f = coulomb/r_r*tanh(slope*v/r_r);
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Line(points={{-80,-50},{-20,-50},{-10,-30},{10,30},{20,50},{80,50}}, color={140,60,0}, thickness=0.5),
      Line(points={{-90,0},{90,0}}, color={160,160,160}), Line(points={{0,80},{0,-80}}, color={160,160,160}),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>f = B<sub>r</sub>/r<sub>r</sub> tanh(&alpha; v/r<sub>r</sub>): (28) at the floor. It is zero at rest, so it cannot
carry a part of a static push.</p>
</html>"));
end TanhRoller;
