within GiveWay;
package Sensors "What is read from the models"
  extends Modelica.Icons.SensorsPackage;
  annotation (
    Documentation(info="<html>
<p>Ideal sensors: they take nothing from what they read.</p>
</html>"));
end Sensors;
