"""What people see. Only here is matplotlib imported."""
