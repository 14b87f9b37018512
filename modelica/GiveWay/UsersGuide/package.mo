within GiveWay;
package UsersGuide "What this package is and where it comes from"
  extends Modelica.Icons.Information;
  annotation (
    Documentation(info="<html>
<p>Concept, equations, literature, contact.</p>
</html>"));
end UsersGuide;
