within GiveWay;
package Components "Parts of robot and testbed"
  extends Modelica.Icons.Package;
  annotation (
    Documentation(info="<html>
<p>From the drivetrain of Fig. 6 to the assembled testbed. Frictions, contacts and latches are written out here: each is
one law of the paper or its literature, with its events.</p>
</html>"));
end Components;
