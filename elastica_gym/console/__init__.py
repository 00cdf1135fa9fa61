"""What commands say to whoever runs them: bad input in one line."""
