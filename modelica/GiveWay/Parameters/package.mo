within GiveWay;
package Parameters "Numbers of robots"
  extends Modelica.Icons.RecordsPackage;
  annotation (
    Documentation(info="<html>
<p>Records made from the robot files that every part of this project reads.</p>
</html>"));
end Parameters;
