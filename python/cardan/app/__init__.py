"""The application: scene files, their answers, pictures, the report and the command."""
