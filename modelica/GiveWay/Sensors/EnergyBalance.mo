within GiveWay.Sensors;
block EnergyBalance "Does a part store or lose what it takes in?"
  import Modelica.Units.SI;
  input SI.Power p_in "Power into the part";
  input SI.Energy stored "Energy stored in it";
  input SI.Power p_loss "Power lost in it";
  SI.Energy taken(start=0, fixed=true) "Work taken in so far";
  SI.Energy lost(start=0, fixed=true) "Energy lost so far";
  parameter SI.Energy stored_start(fixed=false) "Energy stored at the start";
  SI.Energy residual "What is missing: zero but for the solver";
initial equation
  stored_start = stored;
equation
  der(taken) = p_in;
  der(lost) = p_loss;
  residual = taken - lost - (stored - stored_start);
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Ellipse(extent={{-70,70},{70,-70}}, lineColor={64,64,64}, fillColor={255,255,255}, fillPattern=FillPattern.Solid),
      Line(points={{0,0},{40,40}}, color={0,0,0}, thickness=0.5),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>taken = (stored &minus; stored at the start) + lost.</p>
</html>"));
end EnergyBalance;
