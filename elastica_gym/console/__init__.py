"""Messages of commands to their users: bad input, reported in one line."""
