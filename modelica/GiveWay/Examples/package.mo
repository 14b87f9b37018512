within GiveWay;
package Examples "x"
  extends Modelica.Icons.ExamplesPackage;
  annotation (
    Documentation(info="<html>
x
</html>"));
end Examples;
