within GiveWay;
package Interfaces "Connectors and partial models"
  extends Modelica.Icons.InterfacesPackage;
  annotation (
    Documentation(info="<html>
<p>Shafts, rails and bodies in the plane meet in three physical connectors; each has a position, and the force or torque
into the component as its flow variable. Signals carry their unit in the connector's type.</p>
</html>"));
end Interfaces;
