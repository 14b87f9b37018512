within GiveWay;
package Sensors "Sensors for results of the models"
  extends Modelica.Icons.SensorsPackage;
  annotation (
    Documentation(info="<html>
<p>Ideal sensors: they do not act on what they measure.</p>
</html>"));
end Sensors;
