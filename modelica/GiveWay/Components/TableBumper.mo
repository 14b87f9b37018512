within GiveWay.Components;
model TableBumper "Force from a table over travel and speed"
  import Modelica.Units.SI;
  extends Interfaces.PartialLawBumper;
  parameter SI.Position travels[:]={0, 0.05, 0.1, 0.2} "Travels of the rows, rising from 0";
  parameter SI.Velocity speeds[:]={0, 1} "Speeds of the columns, rising; one is 0; compressing is positive";
  parameter SI.Force forces[:, :]={{0, 0}, {40, 60}, {60, 90}, {200, 300}} "Forces, rising along each row";
equation
  f_rest = Functions.tableForce(travels, speeds, forces, c, 0);
  f_rate = Functions.tableForce(travels, speeds, forces, c, u) - f_rest;
  e_law = Functions.tableEnergy(travels, speeds, forces, c);
  assert(travels[1] == 0 and travels[size(travels, 1)] >= travel, "the table does not have the whole travel");
  assert(Functions.isForceTable(travels, speeds, forces),
    "travels or speeds do not rise, none of the speeds is 0, or a force falls with the speed");
  annotation (
    Icon(coordinateSystem(preserveAspectRatio=true, extent={{-100,-100},{100,100}}), graphics={
      Rectangle(extent={{-90,60},{-70,-60}}, lineColor={64,64,64}, fillColor={128,128,128},
        fillPattern=FillPattern.Solid),
      Line(points={{-70,0},{-50,0},{-38,30},{-14,-30},{10,30},{34,-30},{46,0},{70,0}}, color={64,64,64}, thickness=0.5),
      Rectangle(extent={{70,60},{90,-60}}, lineColor={140,60,0}, fillColor={240,190,140},
        fillPattern=FillPattern.Solid),
      Text(extent={{-150,140},{150,100}}, textString="%name", lineColor={0,0,255})}),
    Documentation(info="<html>
<p>Measured forces, linear in travel and speed between the points. Beyond the last travel the force is constant; beyond
the last speeds it goes on with its last slope, and is never negative. The column of speed 0 is what is stored. A force
that fell with the speed would create energy. The default values are made up.</p>
</html>"));
end TableBumper;
