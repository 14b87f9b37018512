within GiveWay;
package UsersGuide "x"
  extends Modelica.Icons.Package;
  annotation (
    Documentation(info="<html>
x
</html>"));
end UsersGuide;
