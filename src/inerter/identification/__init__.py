"""From records to parameters: the virtual rig, the fit, its uncertainty and identifiability."""
