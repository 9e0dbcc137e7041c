"""Contact problems whose data change: the path over the torque, and derivatives of the solution."""
