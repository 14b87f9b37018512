within GiveWay;
package Sources "x"
  extends Modelica.Icons.Package;
  annotation (
    Documentation(info="<html>
x
</html>"));
end Sources;
