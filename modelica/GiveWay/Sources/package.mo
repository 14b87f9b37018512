within GiveWay;
package Sources "Plans, waves and pushes"
  extends Modelica.Icons.SourcesPackage;
  annotation (
    Documentation(info="<html>
<p>What the robot is asked to do, and what is done to it.</p>
</html>"));
end Sources;
