within GiveWay;
package Tests "x"
  extends Modelica.Icons.Package;
  annotation (
    Documentation(info="<html>
x
</html>"));
end Tests;
