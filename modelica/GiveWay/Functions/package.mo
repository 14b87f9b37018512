within GiveWay;
package Functions "Kinematics and motion of the sampled controller"
  extends Modelica.Icons.FunctionsPackage;
  annotation (
    Documentation(info="<html>
<p>Functions of one sample, without states. Vectors are in the plane, x and y.</p>
</html>"));
end Functions;
