"""Contact temperature: heat of friction in a moving band of contact, shared between both flanks."""
