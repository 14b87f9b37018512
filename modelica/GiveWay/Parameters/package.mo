within GiveWay;
package Parameters "Parameters of robots"
  extends Modelica.Icons.RecordsPackage;
  annotation (
    Documentation(info="<html>
<p>Records generated from the robot files that every part of this project reads.</p>
</html>"));
end Parameters;
