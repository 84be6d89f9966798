"""The report's page: what stands on it, part by part, and the one HTML file that holds it all."""
