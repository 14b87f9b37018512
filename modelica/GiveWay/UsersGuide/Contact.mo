within GiveWay.UsersGuide;
class Contact "Who made it"
  extends Modelica.Icons.Contact;
  annotation (
    Documentation(info="<html>
<p>The giveway contributors. MIT licence, without warranty. Questions and mistakes: the issue tracker of the project
that this package belongs to.</p>
</html>"));
end Contact;
