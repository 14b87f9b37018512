within GiveWay;
package Sources "Plans, waves and pushes"
  extends Modelica.Icons.SourcesPackage;
  annotation (
    Documentation(info="<html>
<p>Plans and wheel waves that the robot follows, and pushes and torques that act on it.</p>
</html>"));
end Sources;
