namespace cloudbake {}
