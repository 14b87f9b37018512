within GiveWay;
package Sensors "x"
  extends Modelica.Icons.Package;
  annotation (
    Documentation(info="<html>
x
</html>"));
end Sensors;
