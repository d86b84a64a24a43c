"""Who may do what: users, logins, roles, the command right, and what is looked at in every request."""
