package Modelica "What the tests need of the parts that exports name, written anew from their documented equations"
  package Mechanics
    package Translational
      package Interfaces
        connector Flange_a
          Real s;
          flow Real f;
        end Flange_a;
        connector Flange_b
          Real s;
          flow Real f;
        end Flange_b;
        partial model PartialCompliantWithRelativeStates
          Flange_a flange_a;
          Flange_b flange_b;
          Real s_rel;
          Real v_rel;
          Real f;
        equation
          s_rel = flange_b.s - flange_a.s;
          v_rel = der(s_rel);
          flange_b.f = f;
          flange_a.f = -f;
        end PartialCompliantWithRelativeStates;
      end Interfaces;
      package Components
        model Spring
          extends Modelica.Mechanics.Translational.Interfaces.PartialCompliantWithRelativeStates;
          parameter Real c;
          parameter Real s_rel0 = 0;
        equation
          f = c*(s_rel - s_rel0);
        end Spring;
        model Damper
          extends Modelica.Mechanics.Translational.Interfaces.PartialCompliantWithRelativeStates;
          parameter Real d;
        equation
          f = d*v_rel;
        end Damper;
        model Mass
          Modelica.Mechanics.Translational.Interfaces.Flange_a flange_a;
          Modelica.Mechanics.Translational.Interfaces.Flange_b flange_b;
          parameter Real m;
          parameter Real L = 0;
          Real s;
          Real v;
          Real a;
        equation
          flange_a.s = s - L/2;
          flange_b.s = s + L/2;
          v = der(s);
          a = der(v);
          m*a = flange_a.f + flange_b.f;
        end Mass;
        model Rod
          Modelica.Mechanics.Translational.Interfaces.Flange_a flange_a;
          Modelica.Mechanics.Translational.Interfaces.Flange_b flange_b;
          parameter Real L = 0;
          Real s;
        equation
          flange_a.s = s - L/2;
          flange_b.s = s + L/2;
          0 = flange_a.f + flange_b.f;
        end Rod;
        model Fixed
          Modelica.Mechanics.Translational.Interfaces.Flange_b flange;
          parameter Real s0 = 0;
        equation
          flange.s = s0;
        end Fixed;
      end Components;
      package Sources
        model Speed "With exact=true"
          Modelica.Mechanics.Translational.Interfaces.Flange_b flange;
          parameter Boolean exact = true;
          Real s;
          Real v;
          Real v_ref;
        equation
          s = flange.s;
          v = der(s);
          v = v_ref;
        end Speed;
        model Force
          Modelica.Mechanics.Translational.Interfaces.Flange_b flange;
          Real f;
        equation
          flange.f = -f;
        end Force;
      end Sources;
    end Translational;
    package Rotational
      package Interfaces
        connector Flange_a
          Real phi;
          flow Real tau;
        end Flange_a;
        connector Flange_b
          Real phi;
          flow Real tau;
        end Flange_b;
      end Interfaces;
      package Components
        model Inertia
          Modelica.Mechanics.Rotational.Interfaces.Flange_a flange_a;
          Modelica.Mechanics.Rotational.Interfaces.Flange_b flange_b;
          parameter Real J;
          Real phi;
          Real w;
          Real a;
        equation
          phi = flange_a.phi;
          phi = flange_b.phi;
          w = der(phi);
          a = der(w);
          J*a = flange_a.tau + flange_b.tau;
        end Inertia;
        model Disc
          Modelica.Mechanics.Rotational.Interfaces.Flange_a flange_a;
          Modelica.Mechanics.Rotational.Interfaces.Flange_b flange_b;
          parameter Real deltaPhi = 0;
          Real phi;
        equation
          flange_a.phi = phi - deltaPhi/2;
          flange_b.phi = phi + deltaPhi/2;
          0 = flange_a.tau + flange_b.tau;
        end Disc;
      end Components;
      package Sources
        model Torque
          Modelica.Mechanics.Rotational.Interfaces.Flange_b flange;
          Real tau;
        equation
          flange.tau = -tau;
        end Torque;
      end Sources;
    end Rotational;
  end Mechanics;
end Modelica;
